"""From measured points to findings: kept while they are measured, fitted, chosen from, and compared."""
