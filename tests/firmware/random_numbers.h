/* Random numbers of the fuzzers: the same from the same `state` on every machine. */
static uint64_t state;

static uint64_t next_random(void) { /* xorshift64* */
  state ^= state >> 12;
  state ^= state << 25;
  state ^= state >> 27;
  return state * 2685821657736338717ULL;
}

static double uniform(double low, double high) {
  return low + (high - low) * (double)(next_random() >> 11) / 9007199254740992.0;
}

static int one_in(unsigned n) { return next_random() % n == 0; }
