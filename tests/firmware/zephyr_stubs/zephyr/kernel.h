/* What Zephyr 4 declares, as far as the sample uses it: to compile against, not to run. */
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
int32_t k_msleep(int32_t ms);
int64_t k_uptime_ticks(void);
uint64_t k_ticks_to_us_floor64(uint64_t ticks);
__attribute__((format(printf, 1, 2))) void printk(const char *format, ...);
