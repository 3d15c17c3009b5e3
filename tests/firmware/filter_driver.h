/* Runs a filter over samples, for tests through ctypes; see tests/c_filter_support.py.

   The program that includes this file defines before it:
   STATE                     type of the state
   INPUTS, OUTPUTS           numbers that a sample has beside its time, and that are read after it
   begin(s, params)          begins with PARAMS numbers, or NULL
   take(s, t_s, input)       takes a sample; take_us(s, t_us, input) does so by the clock of 32 bits
   tell(s, output)           writes the outputs
   WORK(s)                   does a portion of work, where the filter has portions
*/
#include <stdlib.h>
#include <string.h>

size_t state_bytes(void) { return sizeof(STATE); }
size_t inputs(void) { return INPUTS; }
size_t outputs(void) { return OUTPUTS; }

/* Saves the state elsewhere, spoils it, and restores it. */
static void save_and_restore(STATE *s) {
  STATE *saved = malloc(sizeof *s);
  memcpy(saved, s, sizeof *s);
  memset(s, 0xA5, sizeof *s);
  memcpy(s, saved, sizeof *s);
  free(saved);
}

#ifndef WORK
#define WORK(s) 0
#endif

/* Does up to so many portions of work; returns 1 if more may be left. */
static unsigned char do_portions(STATE *s, int portions) {
  int is_left = 1;
  while (is_left && portions-- > 0) {
    is_left = WORK(s);
  }
  (void)s;
  return (unsigned char)is_left;
}

/* Returns what `begin` returns. `t` is in s, or in us if `is_us`; after sample `saved_after` the state is restored.
   `portions` may be NULL; else it is the number of portions of work after each sample, and `taken` is 2 or 3 if work may
   be left. */
int drive(const double *params, size_t samples, const double *t, int is_us, const double *input, size_t saved_after,
          const unsigned char *portions, double *output, unsigned char *taken) {
  STATE *s = malloc(sizeof *s);
  const int is_valid = begin(s, params);
  for (size_t i = 0; i < samples; i++) {
    const double *now = input + i * INPUTS;
    taken[i] = (unsigned char)(is_us ? take_us(s, (uint32_t)(uint64_t)t[i], now) : take(s, t[i], now));
    if (i == saved_after) {
      save_and_restore(s);
    }
    if (portions != NULL) {
      taken[i] = (unsigned char)(taken[i] + 2 * do_portions(s, portions[i]));
    }
    tell(s, output + i * OUTPUTS);
  }
  free(s);
  return is_valid;
}
