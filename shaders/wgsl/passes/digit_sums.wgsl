// Uses: passes/digits. Fills: nothing.
// Sums over the lanes of a workgroup, one lane a digit.

var<workgroup> sums: array<u32, DIGITS>;

// The sum of what this and all lower lanes give. All invocations must ask.
fn sum_through(value: u32, lane: u32) -> u32 {
    sums[lane] = value;
    workgroupBarrier();
    for (var stride = 1u; stride < DIGITS; stride *= 2u) {
        var before = 0u;
        if stride <= lane {
            before = sums[lane - stride];
        }
        workgroupBarrier();
        sums[lane] += before;
        workgroupBarrier();
    }
    return sums[lane];
}
