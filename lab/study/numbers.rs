//! The settings of integrators by what they mean, for sweeps and for people.

use voltet_core::parameters::ParameterType;
use voltet_optics::integrators::Integrator;

/// Settings of an integrator; `None`: the integrator has no such setting.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Numbers {
    /// Largest error of a channel of C and of A.
    pub tolerance: Option<f64>,
    /// Pieces or samples of a segment.
    pub count: Option<usize>,
    /// Entries a side of the table.
    pub table_size: Option<usize>,
    /// Pieces from one entry of a pre-integrated table to the next.
    pub oversampling: Option<usize>,
    /// Tiles of a cylindrical table for each entry of a side.
    pub planes: Option<usize>,
}

const TOLERANCE: &str = "tolerance";
const TABLE_SIZE: &str = "table_size";
const OVERSAMPLING: &str = "oversampling";
const PLANES: &str = "planes";

/// The whole number by which an integrator samples a segment: the first that belongs to no table.
fn count_name(integrator: &Integrator) -> Option<&'static str> {
    let is_count = |parameter: &&voltet_core::parameters::Parameter| {
        matches!(parameter.parameter_type, ParameterType::Integer(_))
            && ![TABLE_SIZE, OVERSAMPLING, PLANES].contains(&parameter.name)
    };
    integrator.parameters().iter().find(is_count).map(|parameter| parameter.name)
}

impl Numbers {
    /// The settings of an integrator.
    pub fn of(integrator: &Integrator) -> Numbers {
        Numbers {
            tolerance: integrator.setting(TOLERANCE),
            count: count_name(integrator).and_then(|name| integrator.count(name)),
            table_size: integrator.count(TABLE_SIZE),
            oversampling: integrator.count(OVERSAMPLING),
            planes: integrator.count(PLANES),
        }
    }

    /// An integrator with these settings, as far as it has them.
    pub fn applied_to(&self, integrator: &Integrator) -> Integrator {
        let whole = |number: Option<usize>| number.map(|n| n as f64);
        let settings = [
            (Some(TOLERANCE), self.tolerance),
            (count_name(integrator), whole(self.count)),
            (Some(TABLE_SIZE), whole(self.table_size)),
            (Some(OVERSAMPLING), whole(self.oversampling)),
            (Some(PLANES), whole(self.planes)),
        ];
        settings.into_iter().fold(*integrator, |changed, setting| match setting {
            (Some(name), Some(value)) => changed.with(name, value),
            _ => changed,
        })
    }
}
