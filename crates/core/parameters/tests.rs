//! Declarations that contradict themselves, and those of a program.

use super::*;

const POWER: Parameter = Parameter {
    name: "power",
    parameter_type: ParameterType::Number(Range::within(0.0, 4.0)),
    unit: "",
    default: DefaultValue::Number(1.0),
    help: "help",
};

#[test]
fn declarations_that_contradict_themselves_are_refused() {
    const NO_HELP: &[Parameter] = &[Parameter { help: "", ..POWER }];
    const INNER: &[VariantSchema] = &[VariantSchema { name: "a", summary: "A.", parameters: NO_HELP }];
    let kinds = Parameter {
        parameter_type: ParameterType::Kinds(INNER),
        default: DefaultValue::Unset("none"),
        ..POWER
    };
    let of_standard = |standard| Parameter { default: standard, ..POWER };
    assert!(refuse_contradictions("it", &[POWER], &["type"]).is_ok());
    for (parameters, taken, wanted) in [
        (&[POWER, POWER][..], &[][..], "it declares 'power' twice"),
        (&[POWER], &["power"], "it declares 'power' twice"),
        (NO_HELP, &[], "has no name or no help"),
        (&[kinds], &[], "has no name or no help"),
        (
            &[of_standard(DefaultValue::Number(5.0))],
            &[],
            "of the standard value of it, 'power' is out of range",
        ),
        (
            &[of_standard(DefaultValue::Text("1"))],
            &[],
            "of the standard value of it, 'power' is of the wrong type",
        ),
    ] {
        let message = refuse_contradictions("it", parameters, taken).unwrap_err().to_string();
        assert!(message.contains(wanted), "{message}");
    }
}

#[test]
fn a_program_sets_some_values_and_the_others_are_standard() {
    const SIDE: Parameter = Parameter { name: "side", default: DefaultValue::Unset("either"), ..POWER };
    let set = Parameters::from_values(&[POWER, SIDE], [("power", ParameterValue::Integer(2))]).unwrap();
    assert_eq!((set.number("power").unwrap(), set.optional_number("side")), (2.0, None));
    assert!(set.is_set("power") && !set.is_set("side"));
    assert!(Parameters::from_values(&[POWER], [("power", ParameterValue::Number(5.0))]).is_err());
}
