"""What is known of each effect as a cause: a record each."""
