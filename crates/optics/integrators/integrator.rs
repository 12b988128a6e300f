//! An integrator: its kind, with a number for each parameter of the kind.

use super::adaptive::AdaptiveKind;
use super::analytic::AnalyticKind;
use super::kind::IntegratorKind;
use voltet_core::parameters::{Parameter, ParameterType, Parameters};
use voltet_core::{Error, Result};

/// Parameters of a kind at most.
pub const MAX_SETTINGS: usize = 4;

/// An integrator: its kind and the settings of it.
#[derive(Clone, Copy)]
pub struct Integrator {
    kind: &'static dyn IntegratorKind,
    /// In the order of the kind's parameters.
    settings: [f64; MAX_SETTINGS],
}

impl PartialEq for Integrator {
    fn eq(&self, other: &Integrator) -> bool {
        self.is_kind_of(other) && self.settings == other.settings
    }
}

impl std::fmt::Debug for Integrator {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let mut text = f.debug_struct(self.name());
        for (parameter, value) in self.parameters().iter().zip(self.settings) {
            text.field(parameter.name, &value);
        }
        text.finish()
    }
}

impl Integrator {
    /// Closed forms; quadrature with closed-form optical depth where widgets overlap.
    pub const ANALYTIC: Integrator = Integrator::with_settings(&AnalyticKind, []);

    /// Closed forms, subdivided until the error of (C, A) is under the tolerance, which is above 0.
    pub const fn adaptive(tolerance: f64) -> Integrator {
        Integrator::with_settings(&AdaptiveKind, [tolerance])
    }

    /// An integrator with these settings, in the order of the kind's parameters.
    pub const fn with_settings<const N: usize>(
        kind: &'static dyn IntegratorKind,
        settings: [f64; N],
    ) -> Integrator {
        let mut all = [0.0; MAX_SETTINGS];
        let mut k = 0;
        while k < N {
            all[k] = settings[k];
            k += 1;
        }
        Integrator { kind, settings: all }
    }

    /// An integrator with the default settings of its kind.
    pub fn new(kind: &'static dyn IntegratorKind) -> Integrator {
        let mut integrator = Integrator::with_settings(kind, []);
        for (parameter, setting) in kind.schema().parameters.iter().zip(&mut integrator.settings) {
            let default = parameter.default.datum().map(voltet_core::parameters::LocatedValue::from);
            *setting = default.and_then(|value| value.number()).unwrap_or(0.0);
        }
        integrator
    }

    /// An integrator with the settings that a pipeline states.
    pub fn from_parameters(kind: &'static dyn IntegratorKind, p: &Parameters) -> Result<Integrator> {
        let mut integrator = Integrator::with_settings(kind, []);
        for (parameter, setting) in kind.schema().parameters.iter().zip(&mut integrator.settings) {
            *setting = p.number(parameter.name)?;
        }
        Ok(integrator)
    }

    /// The kind.
    pub fn kind(&self) -> &'static dyn IntegratorKind {
        self.kind
    }

    /// The name in pipeline files.
    pub fn name(&self) -> &'static str {
        self.kind.schema().name
    }

    /// The parameters of the kind.
    pub fn parameters(&self) -> &'static [Parameter] {
        self.kind.schema().parameters
    }

    /// The setting of that name; `None` where the kind has no such parameter.
    pub fn setting(&self, name: &str) -> Option<f64> {
        let place = self.parameters().iter().position(|parameter| parameter.name == name)?;
        Some(self.settings[place])
    }

    /// The largest error that `adaptive` allows; `None` for the other kinds.
    pub fn tolerance(&self) -> Option<f64> {
        self.is_kind_of(&Integrator::adaptive(1.0)).then_some(self.settings[0])
    }

    /// The setting of that name as a whole number.
    pub fn count(&self, name: &str) -> Option<usize> {
        self.setting(name).map(|value| value as usize)
    }

    /// This integrator with another setting; as it is where the kind has no such parameter.
    pub fn with(mut self, name: &str, value: f64) -> Integrator {
        if let Some(place) = self.parameters().iter().position(|parameter| parameter.name == name) {
            self.settings[place] = value;
        }
        self
    }

    /// True if both are of one kind, whatever their settings.
    pub fn is_kind_of(&self, other: &Integrator) -> bool {
        self.name() == other.name()
    }

    /// Checks that the settings are in range.
    pub fn check(&self) -> Result<()> {
        self.kind.check(self)
    }

    /// Checks that each setting lies in the range that its parameter declares.
    pub fn check_ranges(&self) -> Result<()> {
        for (parameter, value) in self.parameters().iter().zip(self.settings) {
            let (range, whole) = match parameter.parameter_type {
                ParameterType::Integer(range) => (range, true),
                ParameterType::Number(range) => (range, false),
                _ => continue,
            };
            if !range.holds(value) || (whole && value.fract() != 0.0) {
                return Err(self.out_of_range(parameter.name, value, range));
            }
        }
        Ok(())
    }

    /// The error for a setting that is out of range.
    pub fn out_of_range(
        &self,
        what: &str,
        value: impl std::fmt::Display,
        accepted: impl std::fmt::Display,
    ) -> Error {
        Error::usage(format!("{what} of the integrator '{}' is out of range", self.name()))
            .got(value)
            .expected(accepted)
    }
}
