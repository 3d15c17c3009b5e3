/* Doubt about an external rest sensor. Twin of contradictions.py. */
#ifndef GD_CONTRADICTIONS_H
#define GD_CONTRADICTIONS_H

#include "real.h"

#define GD_FIT_SIGMAS GD_R(6.0)          /* a block mean further from the bias contradicts the sensor */
#define GD_MOST_CONTRADICTIONS GD_R(5.0) /* contradicting blocks that refute the sensor */
#define GD_FIT_CREDIT GD_R(0.1)          /* contradictions that a block which fits removes */
#define GD_MOST_FIRST GD_R(20.0)         /* largest first bias, in sigmas of the turn-on bias */

/* Counts a block whose rate fits a report of rest. */
static inline void gd_count_fit(gd_real *contradictions) {
  *contradictions = gd_max(GD_R(0.0), *contradictions - GD_FIT_CREDIT);
}

/* Counts a block whose rate contradicts a report of rest; returns whether it refutes the sensor. */
static inline int gd_count_contradiction(gd_real *contradictions) {
  *contradictions += GD_R(1.0);
  if (*contradictions < GD_MOST_CONTRADICTIONS) {
    return 0;
  }
  *contradictions = GD_MOST_CONTRADICTIONS - GD_R(1.0);
  return 1;
}

#endif
