# Install rules: headers, library, program, find_package and pkg-config files.
