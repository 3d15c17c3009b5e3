/* Least processor time of an update of the attitude filter, ns, over five runs.

   attitude_time ROWS COUNT: ROWS is a file of doubles, for each sample t_s, three rates and three accelerations.
*/
#include "gyrodrift.h"
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define RUNS 5

static double run(gd_attitude *a, const double (*rows)[7], size_t count) {
  const clock_t begin = clock();
  gd_attitude_init(a, NULL);
  for (size_t i = 0; i < count; i++) {
    const double *r = rows[i];
    const gd_real gyro[3] = {(gd_real)r[1], (gd_real)r[2], (gd_real)r[3]};
    const gd_real accel[3] = {(gd_real)r[4], (gd_real)r[5], (gd_real)r[6]};
    gd_attitude_update(a, r[0], gyro, accel);
  }
  return 1e9 * (double)(clock() - begin) / CLOCKS_PER_SEC / (double)count;
}

int main(int argc, char **argv) {
  const size_t count = argc == 3 ? (size_t)atol(argv[2]) : 0;
  double(*rows)[7] = malloc(count * sizeof *rows);
  gd_attitude *a = malloc(sizeof *a);
  FILE *file = argc == 3 ? fopen(argv[1], "rb") : NULL;
  double least = 1e30;
  if (file == NULL || fread(rows, sizeof *rows, count, file) != count) {
    return 2;
  }
  for (int k = 0; k < RUNS; k++) {
    const double ns = run(a, (const double(*)[7])rows, count);
    least = ns < least ? ns : least;
  }
  printf("%.0f\n", least);
  return 0;
}
