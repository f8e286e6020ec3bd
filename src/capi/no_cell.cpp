// The entries of cell, schedule, simulation and traces in a build without them: the same symbols,
// each of which says so.
#include "capi/guard.h"

using namespace packcell;

namespace {

pkc_status unsupported() {
    return guard([] {
        fail(Status::kUnsupported, "this build of packcell has no cell (PACKCELL_CELL=OFF)");
    });
}

}  // namespace

extern "C" {

pkc_status pkc_cell_create(const char *, pkc_cell **) { return unsupported(); }
void pkc_cell_free(pkc_cell *) {}
const char *pkc_cell_preset(size_t) { return nullptr; }
pkc_status pkc_cell_load(const char *, size_t, pkc_cell **) { return unsupported(); }
pkc_status pkc_cell_load_file(const char *, pkc_cell **) { return unsupported(); }
pkc_status pkc_cell_save(const pkc_cell *, char *, size_t, size_t *) { return unsupported(); }
pkc_status pkc_cell_save_file(const pkc_cell *, const char *) { return unsupported(); }
pkc_status pkc_cell_info_init(pkc_cell_info *, size_t) { return unsupported(); }
pkc_status pkc_cell_get_info(const pkc_cell *, pkc_cell_info *) { return unsupported(); }
pkc_status pkc_cell_check(const pkc_cell *, const pkc_scenario *) { return unsupported(); }
pkc_status pkc_cell_inverse(const pkc_cell *, int32_t, const double[4], double[PKC_MAX_JOINTS]) {
    return unsupported();
}
pkc_status pkc_cell_forward(const pkc_cell *, int32_t, const double[PKC_MAX_JOINTS], double[4]) {
    return unsupported();
}
pkc_status pkc_layout_options_init(pkc_layout_options *, size_t) { return unsupported(); }
pkc_status pkc_layout_info_init(pkc_layout_info *, size_t) { return unsupported(); }
pkc_status pkc_cell_optimize_layout(const pkc_cell *, const pkc_scenario *,
                                    const pkc_layout_options *, pkc_layout_info *, pkc_cell **) {
    return unsupported();
}
pkc_status pkc_allocate(const pkc_cell *, const pkc_queue *, pkc_action *, size_t) {
    return unsupported();
}
pkc_status pkc_schedule_create(const pkc_cell *, const pkc_scenario *, int32_t, pkc_schedule **) {
    return unsupported();
}
void pkc_schedule_free(pkc_schedule *) {}
pkc_status pkc_schedule_add_step(pkc_schedule *, const pkc_bin *, const pkc_queue *,
                                 const pkc_action *, size_t) {
    return unsupported();
}
pkc_status pkc_schedule_put_aside(pkc_schedule *, int32_t, double) { return unsupported(); }
pkc_status pkc_schedule_info_init(pkc_schedule_info *, size_t) { return unsupported(); }
pkc_status pkc_schedule_get_info(const pkc_schedule *, pkc_schedule_info *) {
    return unsupported();
}
pkc_status pkc_schedule_sample(const pkc_schedule *, int32_t, double, pkc_arm_sample *) {
    return unsupported();
}
pkc_status pkc_simulation_options_init(pkc_simulation_options *, size_t) { return unsupported(); }
pkc_status pkc_simulate(const pkc_schedule *, const pkc_simulation_options *, pkc_simulation **) {
    return unsupported();
}
void pkc_simulation_free(pkc_simulation *) {}
pkc_status pkc_simulation_info_init(pkc_simulation_info *, size_t) { return unsupported(); }
pkc_status pkc_simulation_get_info(const pkc_simulation *, pkc_simulation_info *) {
    return unsupported();
}
pkc_status pkc_simulation_places(const pkc_simulation *, pkc_place *, size_t, size_t *) {
    return unsupported();
}
pkc_status pkc_trace_write_file(const pkc_schedule *, const pkc_simulation *, int32_t, double,
                                const char *) {
    return unsupported();
}

}  // extern "C"
