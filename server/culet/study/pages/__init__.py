"""A study's report as a page of HTML, with its figures."""
