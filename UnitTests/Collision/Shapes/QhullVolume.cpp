#include <Fulcrum/UnitTests/Collision/Shapes/QhullVolume.h>

#include <libqhull_r/qhull_ra.h>

#include <cstdio>
#include <memory>
#include <vector>

namespace fulcrum::test {

std::optional<HullSize> QhullSize(std::span<const Position> points) {
    std::vector<coordT> coordinates;
    for (const Position& p : points) coordinates.insert(coordinates.end(), p.data(), p.data() + 3);
    const std::unique_ptr<FILE, int (*)(FILE*)> silence(std::fopen("/dev/null", "w"), std::fclose);

    qhT state;
    qh_zero(&state, silence.get());
    char command[] = "qhull FA";
    const int error = qh_new_qhull(&state, 3, static_cast<int>(points.size()), coordinates.data(), False, command,
                                   silence.get(), silence.get());
    std::optional<HullSize> size;
    if (error == 0) {
        qh_getarea(&state, state.facet_list);
        size = HullSize{state.totvol, state.totarea};
    }
    qh_freeqhull(&state, qh_ALL);
    int current = 0, total = 0;
    qh_memfreeshort(&state, &current, &total);
    return size;
}

}  // namespace fulcrum::test
