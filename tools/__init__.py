"""Tools for developers: sample characters and clips, contact sheets, pictures for the documentation."""
