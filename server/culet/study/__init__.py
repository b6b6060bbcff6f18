"""What each approximation and each feature costs, measured on the machine at hand."""
