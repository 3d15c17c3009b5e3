/* The recursion of gyrodrift.filter for one candidate after the other: what a plain compiled loop costs. */

#include <math.h>
#include <stddef.h>

enum { TABLE = 512 };

static double attenuated_step(const double *params, double run)
{
    double steepness = pow(run, params[4]);
    return isinf(steepness) ? 0.0 : (1.0 + params[3]) / (1.0 + params[3] * steepness) * params[0];
}

/* Sum of the squared yaw errors of one candidate, deg2, over the samples with a finite reference. */
static double squares_of(size_t n, const double *dt_s, const double *rate_dps, const double *reference_deg,
                         const double *params)
{
    const double tau_s = params[1], theta_w_dps = params[2];
    double lpf = rate_dps[0], omega = rate_dps[0], i = 0.0, yaw = 0.0, squares = 0.0;
    double steps[TABLE];
    long run = 1;
    int sign_before = 2;

    for (int r = 0; r < TABLE; r++)
        steps[r] = attenuated_step(params, r);
    for (size_t k = 1; k < n; k++) {
        const double t = dt_s[k], before = omega;
        const int sign = (before > 0.0) - (before < 0.0);
        run = sign == sign_before ? run + 1 : 1;
        if (fabs(before) < theta_w_dps)
            i -= sign * (run < TABLE ? steps[run] : attenuated_step(params, (double)run));
        lpf = (rate_dps[k] * t + tau_s * lpf) / (t + tau_s);
        omega = lpf + i;
        yaw += (omega + tau_s / t * (omega - before)) * t;
        sign_before = sign;
        if (isfinite(reference_deg[k])) {
            const double error = yaw - reference_deg[k];
            squares += error * error;
        }
    }
    return squares;
}

void hdr_squares(size_t n, const double *dt_s, const double *rate_dps, const double *reference_deg,
                 size_t candidates, const double *params, double *squares)
{
    for (size_t c = 0; c < candidates; c++)
        squares[c] = squares_of(n, dt_s, rate_dps, reference_deg, params + 5 * c);
}
