"""A stone cut anew: angles and heights changed with its meets kept, in shapes and in cutters' designs."""
