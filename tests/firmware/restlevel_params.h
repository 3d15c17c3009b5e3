/* Parameters of restlevel from an array, in the order of gd_restlevel_params. Returns NULL for NULL: the defaults. */
static inline const gd_restlevel_params *restlevel_params(gd_restlevel_params *p, const double *values) {
  if (values == NULL) {
    return NULL;
  }
  p->window_s = (gd_real)values[0];
  p->quiet = (gd_real)values[1];
  p->turn_on_dps = (gd_real)values[2];
  p->walk_dps_rts = (gd_real)values[3];
  p->drift_dps_s = (gd_real)values[4];
  p->still_start = (gd_real)values[5];
  p->rest_share = (gd_real)values[6];
  p->scale_percent = (gd_real)values[7];
  return p;
}
