"""Who is who: the server's own address, folder and token, whom a request is from, and from which page it comes."""
