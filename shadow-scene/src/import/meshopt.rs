//! EXT_meshopt_compression.
