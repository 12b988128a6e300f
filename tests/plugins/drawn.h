/* Numbers drawn from `state`, alike on every machine. */
#include <stdint.h>

static uint64_t state;

/* Steele, Lea, Flood 2014: SplitMix64. */
static uint64_t draw(void) {
    uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static uint64_t below(uint64_t n) { return draw() % n; }
