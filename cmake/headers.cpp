// Nothing but a source for the targets that precompile headers.
