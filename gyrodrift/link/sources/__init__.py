"""Sources of bytes that are no serial ports: the network, standard input, growing files."""
