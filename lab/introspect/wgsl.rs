//! Segment formulas of the GPU engine, for the judge; and floating-point operations of a shader's functions, counted in its text.
//!
//! Sums, products, quotients, minima, maxima and elementary functions count one a lane, a multiply-add two; comparisons,
//! choices, signs and integers none. Of two branches the longer counts, of a loop one round: what loops is counted too low.

use naga::proc::TypeResolution;
use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{
    BinaryOperator, Block, Expression, Function, Handle, MathFunction, Module, ScalarKind, Statement,
    TypeInner,
};
use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_gpu::Device;
use voltet_judge::{
    Chain, Condition, Conditions, EvalOutcome, PartialIntegrals, Precision, SegmentEvaluator,
};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_shaders::Shader;
use voltet_shaders::segment_list::origin;

/// Composed shaders of a device. A device that fails on the way gives no numbers, which no bound allows.
pub struct WgslEvaluator {
    device: Arc<Device>,
    name: String,
}

impl WgslEvaluator {
    pub fn new(device: Arc<Device>) -> WgslEvaluator {
        let name = format!("WGSL on {}", device.name);
        WgslEvaluator { device, name }
    }
}

impl SegmentEvaluator for WgslEvaluator {
    fn name(&self) -> &str {
        &self.name
    }

    fn precision(&self) -> Precision {
        Precision::Wgsl
    }

    /// Values are stored about one origin, or else as 32-bit numbers that all widgets share. Where rounding those leaves no digit
    /// of T, no linear condition number bounds C and A.
    fn condition(&self, transfer_function: &TransferFunction, of: &Conditions) -> Condition {
        match (origin(&transfer_function.widgets), of.values_keep_digits()) {
            (Some(_), _) => of.differences,
            (None, true) => of.values,
            (None, false) => [None; 3],
        }
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome> {
        let contribution = self.device.integrate_segment(transfer_function, segment, overlap)?;
        Ok(contribution.map_or_else(EvalOutcome::Skipped, EvalOutcome::Served))
    }

    fn chain(&self, segments: &[Contribution]) -> Chain {
        let values = self.device.composite_chain(segments);
        let [red, green, blue, _, transparency, opacity] = values.unwrap_or([f64::NAN; 6]);
        Chain { color: [red, green, blue], opacity, transparency: Some(transparency) }
    }

    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
        let [psi, front, back, zeta] = self.device.partial_integrals(a, b)?;
        Ok(EvalOutcome::Served(PartialIntegrals { psi, front, back, zeta }))
    }
}

/// Lower bound of the floating-point operations of a picture's compositor: for each segment its crossing of the cell's planes, and
/// its integral. Cells that a ray misses are not counted.
///
/// # Errors
///
/// - A shader's text that cannot be read.
pub(crate) fn compositor_operations(shader: &Shader, segments: u64) -> Result<u64> {
    let operations = OperationCounter::new(shader)?;
    // One of the two, by the compositor.
    let shades = ["shade_again", "shade_in_chunk"].map(|name| operations.in_function(name));
    Ok(segments * (operations.in_function("cross_faces") + shades[0] + shades[1]))
}

struct OperationCounter {
    module: Module,
    info: ModuleInfo,
}

impl OperationCounter {
    /// Reads the text of a composed shader. Errors: it is no WGSL.
    fn new(shader: &Shader) -> Result<OperationCounter> {
        let wrong = |why: &dyn std::fmt::Display| Error::run("a shader's text cannot be read").got(why);
        let module = naga::front::wgsl::parse_str(&shader.text).map_err(|error| wrong(&error))?;
        let validated = Validator::new(ValidationFlags::all(), Capabilities::all()).validate(&module);
        let info = validated.map_err(|error| wrong(error.as_inner()))?;
        Ok(OperationCounter { module, info })
    }

    /// Operations of one call of a function and all that it calls; 0 for one that the text does not have.
    fn in_function(&self, name: &str) -> u64 {
        let mut all = self.module.functions.iter();
        all.find(|(_, function)| function.name.as_deref() == Some(name)).map_or(0, |(at, _)| self.call(at))
    }

    // WGSL has no recursion.
    fn call(&self, at: Handle<Function>) -> u64 {
        let function = &self.module.functions[at];
        self.block(&function.body, function, &self.info[at])
    }

    fn block(&self, block: &Block, function: &Function, info: &FunctionInfo) -> u64 {
        let within = |block: &Block| self.block(block, function, info);
        let statement = |statement: &Statement| match statement {
            Statement::Emit(range) => range.clone().map(|at| self.expression(function, info, at)).sum(),
            Statement::Block(block) => within(block),
            Statement::If { accept, reject, .. } => within(accept).max(within(reject)),
            Statement::Switch { cases, .. } => cases.iter().map(|case| within(&case.body)).max().unwrap_or(0),
            Statement::Loop { body, continuing, .. } => within(body) + within(continuing),
            Statement::Call { function, .. } => self.call(*function),
            _ => 0,
        };
        block.iter().map(statement).sum()
    }

    fn expression(&self, function: &Function, info: &FunctionInfo, at: Handle<Expression>) -> u64 {
        match &function.expressions[at] {
            Expression::Binary { op, left, right } => {
                use BinaryOperator::{Add, Divide, Multiply, Subtract};
                match (op, self.inner(info, *left), self.inner(info, *right)) {
                    // A sum of products for each row.
                    (Multiply, TypeInner::Matrix { columns, rows, .. }, TypeInner::Vector { .. }) => {
                        *rows as u64 * (2 * *columns as u64 - 1)
                    }
                    (Add | Subtract | Multiply | Divide, ..) => self.lanes(info, at),
                    _ => 0,
                }
            }
            Expression::Math { fun, arg, .. } => {
                let n = self.lanes(info, *arg);
                match fun {
                    MathFunction::Abs | MathFunction::Sign => 0,
                    MathFunction::Fma | MathFunction::Clamp => 2 * n,
                    MathFunction::Mix => 3 * n,
                    MathFunction::Dot => (2 * n).saturating_sub(1),
                    MathFunction::Cross => 9,
                    MathFunction::Length => 2 * n,
                    MathFunction::Distance => 3 * n,
                    MathFunction::Normalize => 3 * n + 1,
                    _ => n,
                }
            }
            _ => 0,
        }
    }

    fn inner<'a>(&'a self, info: &'a FunctionInfo, at: Handle<Expression>) -> &'a TypeInner {
        match &info[at].ty {
            TypeResolution::Handle(at) => &self.module.types[*at].inner,
            TypeResolution::Value(inner) => inner,
        }
    }

    /// Floats side by side in a value; 0 for others.
    fn lanes(&self, info: &FunctionInfo, at: Handle<Expression>) -> u64 {
        match self.inner(info, at) {
            TypeInner::Scalar(scalar) if scalar.kind == ScalarKind::Float => 1,
            TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Float => *size as u64,
            TypeInner::Matrix { columns, rows, .. } => *columns as u64 * *rows as u64,
            _ => 0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "
        @group(0) @binding(0) var<storage, read_write> out: array<vec4f>;
        fn line(a: vec4f, b: vec4f) -> vec4f { return a * b + vec4f(1.0); }
        fn all(m: mat4x4f, v: vec4f, i: u32) -> vec4f {
            var sum = fma(v, v, line(m * v, v));
            let j = i * 3u + 1u;
            if j < 4u { sum += vec4f(dot(v, v)); } else { sum.x = exp(sum.x); }
            return select(sum, -sum, j == 2u);
        }
        @compute @workgroup_size(1)
        fn main() { out[0] = all(mat4x4f(), out[1], 2u); }
    ";

    #[test]
    fn operations_are_those_counted_by_hand() {
        let module = naga::front::wgsl::parse_str(TEXT).expect("is WGSL");
        let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        let operations = OperationCounter { info: info.expect("is valid"), module };
        assert_eq!(operations.in_function("line"), 8);
        // fma 8, line 8, matrix 4 × 7, and the longer branch: dot 7, sum 4.
        assert_eq!(operations.in_function("all"), 8 + 8 + 28 + 11);
        assert_eq!(operations.in_function("none"), 0);
    }
}
