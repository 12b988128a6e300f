//! Variables of an Exodus file, which is netCDF in its own form or in HDF5.

use crate::formats::contents::{Meter, Stored};
use crate::formats::hdf5;
use crate::formats::netcdf;
use crate::formats::numbers::Target;
use crate::formats::source::Source;
use std::collections::HashSet;
use std::sync::Arc;
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result};

pub(super) enum Variables {
    Classic(netcdf::NetcdfFile),
    Hdf5 { root: hdf5::Group, names: HashSet<String> },
}

impl Variables {
    /// Opens a file of either form.
    pub fn open(source: Arc<Source>) -> Result<Variables> {
        if netcdf::is_netcdf(&source.head(4)?) {
            return netcdf::NetcdfFile::open(source).map(Variables::Classic);
        }
        Variables::of_root(hdf5::Group::root(source)?)
    }

    /// The variables in HDF5.
    pub fn of_root(root: hdf5::Group) -> Result<Variables> {
        let names = root.names()?.into_iter().collect();
        Ok(Variables::Hdf5 { root, names })
    }

    /// Form of the file, for people.
    pub fn form(&self) -> &'static str {
        if matches!(self, Variables::Classic(_)) { "netCDF" } else { "netCDF in HDF5" }
    }

    /// The file, for arrays that are computed.
    pub fn source(&self) -> &Arc<Source> {
        match self {
            Variables::Classic(file) => &file.source,
            Variables::Hdf5 { root, .. } => root.source(),
        }
    }

    pub fn has(&self, name: &str) -> bool {
        match self {
            Variables::Classic(file) => file.variable(name).is_some(),
            Variables::Hdf5 { names, .. } => names.contains(name),
        }
    }

    /// The greatest number of variables `stem1`, `stem2`, …; 0 where there is none.
    pub fn greatest_of(&self, stem: &str) -> usize {
        let number = |name: &str| name.strip_prefix(stem).and_then(|number| number.parse().ok());
        let numbers: Option<usize> = match self {
            Variables::Classic(file) => file.names().filter_map(number).max(),
            Variables::Hdf5 { names, .. } => names.iter().filter_map(|name| number(name)).max(),
        };
        numbers.unwrap_or(0)
    }

    /// Numbers along each axis of a variable, if there is one.
    pub fn shape(&self, name: &str) -> Result<Option<Vec<u64>>> {
        Ok(match self {
            Variables::Classic(file) => file.variable(name).map(|variable| variable.shape.clone()),
            Variables::Hdf5 { root, .. } if self.has(name) => {
                root.array(name)?.map(|array| array.shape().to_vec())
            }
            Variables::Hdf5 { .. } => None,
        })
    }

    pub fn attribute(&self, variable: &str, name: &str) -> Result<Option<String>> {
        Ok(match self {
            Variables::Classic(file) => {
                file.variable(variable).and_then(|own| own.attribute(name)).map(str::to_owned)
            }
            Variables::Hdf5 { root, .. } => match root.array(variable)? {
                Some(array) => array.text_attribute(name)?,
                None => None,
            },
        })
    }

    /// Part of a variable as an array of tuples: the numbers at these places along its first axes.
    pub fn part(&self, variable: &str, places: &[u64], name: &str, component_count: usize) -> Result<Stored> {
        let missing = || Error::run(format!("the file lacks the variable '{variable}'"));
        match self {
            Variables::Classic(file) => {
                file.part(file.variable(variable).ok_or_else(missing)?, places, name, component_count)
            }
            Variables::Hdf5 { root, .. } => {
                let array = root.array(variable)?.ok_or_else(missing)?;
                let rest = array.shape().iter().skip(places.len()).map(|&n| (0, n, 1));
                let part: Vec<hdf5::Extent> = places.iter().map(|&place| (place, 1, 1)).chain(rest).collect();
                array.part(name, &part, component_count)
            }
        }
    }

    /// All numbers of a small variable, none where it is not there.
    pub fn numbers<T: Target>(&self, name: &str) -> Result<Vec<T>> {
        let Some(shape) = self.shape(name)? else { return Ok(Vec::new()) };
        let meter = Meter::new(&NoProgress, 1);
        let lies_apart = match self {
            Variables::Classic(file) => file.variable(name).is_some_and(|own| file.lies_apart(own)),
            Variables::Hdf5 { .. } => false,
        };
        if !lies_apart {
            return self.part(name, &[], name, 1)?.load(&meter);
        }
        let mut numbers = Vec::new();
        for place in 0..shape.first().copied().unwrap_or(0) {
            numbers.extend(self.part(name, &[place], name, 1)?.load::<T>(&meter)?);
        }
        Ok(numbers)
    }

    /// Rows of text, none where there is no such variable.
    pub fn texts(&self, name: &str) -> Result<Vec<String>> {
        let Some(shape) = self.shape(name)? else { return Ok(Vec::new()) };
        let len = shape.last().map_or(1, |&len| usize::try_from(len).unwrap_or(usize::MAX).max(1));
        match self {
            Variables::Classic(_) => {
                let bytes: Vec<u8> = self.numbers(name)?;
                Ok(bytes.chunks(len).map(netcdf::text).collect())
            }
            Variables::Hdf5 { root, .. } => root.required_array(name)?.rows_of_text(),
        }
    }
}
