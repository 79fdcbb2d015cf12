"""The long runs that a version must pass, and the page that tells when it did."""
