#include <Fulcrum/Constraints/Parts/SpringSettings.h>

#include <cmath>
#include <cstdio>

namespace fulcrum {

Status Validate(const SpringSettings& settings) {
    if (settings.mode > SpringMode::StiffnessAndDamping)
        return Error{ErrorCode::OutOfRange,
                     "spring mode is " + std::to_string(static_cast<int>(settings.mode)) + "; it must be from 0 to 1"};
    if (settings.form > SpringForm::Implicit)
        return Error{ErrorCode::OutOfRange,
                     "spring form is " + std::to_string(static_cast<int>(settings.form)) + "; it must be from 0 to 2"};
    const struct {
        const char* name;
        float value;
    } fields[] = {{"frequency", settings.frequency},
                  {"dampingRatio", settings.dampingRatio},
                  {"stiffness", settings.stiffness},
                  {"damping", settings.damping}};
    for (const auto& field : fields) {
        const bool finite = std::isfinite(field.value);
        if (finite && field.value >= 0.0f) continue;
        char message[96];
        std::snprintf(message, sizeof(message), "spring %s is %g; it must be %s", field.name,
                      static_cast<double>(field.value), finite ? "0 or more" : "finite");
        return Error{finite ? ErrorCode::Negative : ErrorCode::NonFinite, message};
    }
    return Done{};
}

}  // namespace fulcrum
