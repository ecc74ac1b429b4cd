"""Pages of the documentation that are made from the code: options, settings, operators, reports, modules."""
