"""The claims of the paper, each a test of tables of ensembles."""
