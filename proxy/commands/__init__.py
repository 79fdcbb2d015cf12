"""The subcommands of `sendworthy`, one per file; each file imports little until its command runs."""
