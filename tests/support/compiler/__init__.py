"""What the tests of the compiler compile."""
