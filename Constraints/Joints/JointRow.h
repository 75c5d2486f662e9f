// What the type of a joint asks for in one step beyond its locks: rows for limits in reach, motors that are on, springs
// and friction. Filled once a step by the types (JointType.h), solved in lanes (JointBatch.h). Plain data, no threads.
//
// A row is one equation between two bodies A and B: dC/dt = J v.
#pragma once

#include <Fulcrum/Constraints/Parts/RowJacobian.h>
#include <Fulcrum/Constraints/Parts/SpringSettings.h>

#include <limits>
#include <new>
#include <type_traits>

namespace fulcrum {

struct JointRow {
    enum class Kind : uint8_t {
        Equal,          // C = 0
        AtLeast,        // C >= 0: pushes C up, never down
        Spring,         // C = 0, as softly as `spring` says
        SpringAtLeast,  // the same, where C < 0
        Speed,          // J v = speed: motors, and friction with speed 0
    };
    static constexpr float kUnlimited = std::numeric_limits<float>::infinity();

    Kind kind = Kind::Equal;
    uint8_t slot = 0;  // which of its type's rows it is: its impulse of the last step is kept by that number
    RowJacobian<float>
        jacobian;             // of an axis, angle, gear, rack-and-pinion or independent-axis part (Constraints/Parts)
    float error = 0;          // C at the start of the step, m or rad
    float speed = 0;          // m/s or rad/s
    bool yields = true;       // softly, as the locks of joints do; not where a motor presses against it
    bool turnsWithA = false;  // all of J does, from substep to substep; else it stays as it is
    bool about = false;       // C is an angle, though bodies' places may count too; set by SetAbout
    bool radial = false;      // acts along the line from A's anchor to B's and follows it as it turns
    float minForce = -kUnlimited, maxForce = kUnlimited;  // N or N m
    SpringSettings spring;
};

// The rows of one joint in one step. Only rows that were added are ever set: a list is made for every joint with rows
// in every step, and clearing all its room took ten times as long as most joints need to fill it.
struct JointRowList {
    static constexpr uint32_t kMaxRows = 24;  // six axes, each with two limits, a motor and friction

    class Rows {
    public:
        Rows() {}
        JointRow& operator[](size_t i) { return rows_[i]; }
        const JointRow& operator[](size_t i) const { return rows_[i]; }

    private:
        union {
            JointRow rows_[kMaxRows];
        };
    };
    Rows rows;
    uint32_t count = 0;

    // A new row in the slot, to be filled.
    JointRow& Add(uint32_t slot, JointRow::Kind kind) {
        FULCRUM_ASSERT(count < kMaxRows && slot < kMaxRows);
        JointRow& row = *new (&rows[count++]) JointRow();
        row.slot = static_cast<uint8_t>(slot);
        row.kind = kind;
        return row;
    }
};
static_assert(std::is_trivially_destructible_v<JointRow>);

}  // namespace fulcrum
