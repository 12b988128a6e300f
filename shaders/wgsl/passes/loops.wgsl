// Uses: passes/view. Fills: nothing.
// Whether loops do their rounds. Mesa's software driver ends every loop after its first round, without a word, once an
// invocation's loops have made 65,535 rounds in all; what was computed by then is wrong.

const CANARY_ROUNDS = 3u;

// Asked at the end of what loops. The budget is more, but no compiler knows.
fn do_loops_run() -> bool {
    let rounds = min(view.budget, CANARY_ROUNDS);
    var round = 0u;
    while round < rounds {
        round++;
    }
    return round == rounds;
}
