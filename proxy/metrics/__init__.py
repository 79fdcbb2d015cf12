"""What Prometheus can read of a running daemon: its status, as metrics over HTTP, while `metrics.listen` says where."""
