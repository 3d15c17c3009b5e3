/* Kinds of parts by their bias at power-on, for both filters. Twin of PARTS in restlevel/hypotheses.py. */
#ifndef GD_PARTS_H
#define GD_PARTS_H

#include "real.h"

#define GD_PARTS 4

/* Share of a kind. */
static inline gd_real gd_part_share(uint8_t kind) {
  return kind < 2 ? GD_R(0.25) : kind == 2 ? GD_R(0.48) : GD_R(0.02);
}

/* Sigma of its bias over `turn_on_dps`: the first two subtract their own bias, the last is raw. */
static inline gd_real gd_part_wider(uint8_t kind) {
  return kind == 0 ? GD_R(0.01) : kind == 1 ? GD_R(0.1) : kind == 2 ? GD_R(1.0) : GD_R(8.0);
}

#endif
