"""What starts the processes of `culet serve` and keeps them running."""
