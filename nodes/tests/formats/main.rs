//! Reading files of every format.

mod real_files;
