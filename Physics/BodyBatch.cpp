#include <Fulcrum/Physics/BodyBatch.h>

#include <Fulcrum/Physics/Validation.h>

namespace fulcrum {

Result<BodyBatch> BodyBatch::Prepare(std::vector<BodySettings> bodies) {
    for (size_t i = 0; i < bodies.size(); ++i)
        if (MaybeError e = Check(bodies[i])) return Error{e->code, "bodies[" + std::to_string(i) + "]: " + e->message};
    return BodyBatch(std::move(bodies));
}

}  // namespace fulcrum
