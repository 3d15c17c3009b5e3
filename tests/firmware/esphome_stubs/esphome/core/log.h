/* As in component.h. */
#pragma once
#include <cstdio>
#define ESP_LOGD(tag, ...) std::printf(__VA_ARGS__), (void)(tag)
#define ESP_LOGE ESP_LOGD
#define ESP_LOGCONFIG ESP_LOGD
#define LOG_UPDATE_INTERVAL(component) (void)(component)
