"""The judge: where the simulator meets perception."""
