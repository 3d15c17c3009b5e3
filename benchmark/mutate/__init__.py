"""Mutation: named faults that an engineer could make are put into a copy of the project; related tests must fail."""
