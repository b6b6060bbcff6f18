"""What answers are made of, whatever they answer: problem documents, pictures, the page's files, and headers."""
