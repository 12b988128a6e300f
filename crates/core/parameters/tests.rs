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

#[test]
fn names_of_entries_are_no_difference() {
    const NAMED: Parameter = Parameter {
        name: ENTRY_NAME,
        parameter_type: ParameterType::Text,
        default: DefaultValue::Unset("none"),
        ..POWER
    };
    const KEYS: &[Parameter] = &[POWER, NAMED];
    const LIST: Parameter = Parameter {
        name: "list",
        parameter_type: ParameterType::Kinds(&[VariantSchema { name: "a", summary: "A.", parameters: KEYS }]),
        default: DefaultValue::Unset("none"),
        ..POWER
    };
    let with = |power: f64, name: Option<&str>| {
        let fields = [
            Some(Field::new("kind", "a")),
            Some(Field::new("power", power)),
            name.map(|name| Field::new("name", name)),
        ];
        let entry = ParameterValue::Table(fields.into_iter().flatten().collect());
        Parameters::from_values(&[LIST], [("list", [entry].into_iter().collect())]).unwrap()
    };
    assert_eq!(with(2.0, None), with(2.0, Some("bone")));
    assert_eq!(with(2.0, Some("skin")), with(2.0, Some("bone")));
    assert_ne!(with(2.0, Some("bone")), with(3.0, Some("bone")));
}
