// The fixture of tests that use a Vulkan device without a renderer: the default device, with validation where the layer
// is installed, whose silence is asked for at the end.
#pragma once

#include <gtest/gtest.h>

#include "client/render/device.h"
#include "client/render/device_choice.h"

namespace citystream::client::test {

class DeviceTest : public testing::Test {
  protected:
    void SetUp() override {
        instance_ = create_instance(validation_layer_installed());
        const Result<VkPhysicalDevice> physical = choose_device(instance_, "", {});
        ASSERT_TRUE(physical.ok());
        device_ = create_device(*physical);
    }
    /// After whatever lives on the device is gone.
    void TearDown() override {
        destroy_device(device_);
        EXPECT_EQ(instance_.messages->load(), 0u);
        destroy_instance(instance_);
    }

    Instance instance_;
    Device device_;
};

}  // namespace citystream::client::test
