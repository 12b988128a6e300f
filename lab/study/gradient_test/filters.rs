//! The filters that are measured.

use voltet_core::field::Method;
use voltet_core::{Error, Result};
use voltet_graph::{Field, Parameters, Registry, SourceSpan};

/// The filter of this name with what is set of its parameters, then those `beside` it with their standard values: all others that can
/// be tested, without names.
///
/// Errors: no such filter or parameter; a filter that reads arrays, of which manufactured grids carry none.
pub fn methods(
    name: &str,
    set: &[Field],
    beside: Option<&[String]>,
    registry: &Registry,
) -> Result<Vec<Method>> {
    let filter = registry.find_filter(name)?.clone();
    let declared = filter.declaration().parameters;
    let parameters = Parameters::check(declared, set, &SourceSpan::Nowhere, &[])?;
    let method = Method::new(filter, parameters)?;
    if let Some(array) = method.arrays()?.into_iter().next() {
        let error = Error::usage("the filter reads a point array, and manufactured grids carry none");
        return Err(error
            .got(format!("'{array}'"))
            .expected("a filter that computes gradients")
            .at_item(name));
    }
    let mut methods = vec![method];
    let others: Vec<String> = match beside {
        Some(names) => names.to_vec(),
        None => registry.filters().map(|filter| filter.declaration().name.to_string()).collect(),
    };
    for name in others.iter().filter(|other| *other != name && !other.is_empty()) {
        // Those that cannot go without parameters or arrays are left out, unless they were asked for.
        let other = Method::with_defaults(registry.find_filter(name)?.clone());
        match other.and_then(|other| other.arrays().map(|arrays| (other, arrays))) {
            Ok((other, arrays)) if arrays.is_empty() => methods.push(other),
            Ok((_, arrays)) if beside.is_some() => {
                let error = Error::usage("the filter reads a point array, and manufactured grids carry none");
                return Err(error.got(arrays.join(", ")).at_item(name));
            }
            Err(error) if beside.is_some() => return Err(error.at_item(name)),
            _ => {}
        }
    }
    Ok(methods)
}
