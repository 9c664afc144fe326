#include "runtime/drivers/response.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry/error.h"
#include "runtime/asset.h"

namespace fascia::runtime {
namespace {

const std::vector<float> weights = {0.1F, 0.25F, 0.5F, 0.75F};

TEST(Response, IsTheWeightItselfWithoutKnots) {
  const Response response;
  for (const float weight : {-2.0F, -0.3F, 0.0F, 0.7F, 1.0F, 1.5F}) {
    EXPECT_EQ(response.share(weight), weight);
    EXPECT_EQ(response.slope(weight), 1.0F);
  }
}

TEST(Response, PassesThroughItsKnotsAndEnds) {
  const std::vector<float> shares = {0.04F, 0.11F, 0.27F, 0.5F};
  const Response response(weights, shares);
  EXPECT_EQ(response.share(0.0F), 0.0F);
  EXPECT_EQ(response.share(1.0F), 1.0F);
  for (size_t k = 0; k < weights.size(); ++k) {
    EXPECT_NEAR(response.share(weights[k]), shares[k], 1e-6F);
    EXPECT_NEAR(response.share(-weights[k]), -shares[k], 1e-6F) << "a signed weight plays the same way back";
  }
  EXPECT_EQ(response.share(1.5F), 1.5F);
}

TEST(Response, OfKnotsOnTheDiagonalIsTheWeight) {
  const Response response(weights, weights);
  for (float weight = 0.0F; weight <= 1.0F; weight += 0.01F) {
    EXPECT_NEAR(response.share(weight), weight, 1e-6F);
    EXPECT_NEAR(response.slope(weight), 1.0F, 1e-5F);
  }
}

TEST(Response, RisesThroughoutAndItsSlopeIsItsDerivative) {
  for (const std::vector<float>& shares :
       {std::vector<float>{0.04F, 0.11F, 0.27F, 0.5F}, std::vector<float>{0.2F, 0.2F, 0.9F, 0.95F},
        std::vector<float>{0.0F, 0.0F, 0.0F, 1.0F}}) {
    const Response response(weights, shares);
    float before = 0.0F;
    for (int i = 1; i <= 1000; ++i) {
      const float weight = static_cast<float>(i) / 1000.0F, share = response.share(weight);
      EXPECT_GE(share, before - 1e-6F) << weight;
      before = share;
    }
    for (int i = 1; i < 200; ++i) {
      const float weight = static_cast<float>(i) / 200.0F, step = 1e-3F;
      const float difference =
          (response.share(weight + step) - response.share(weight - step)) / (2.0F * step);
      EXPECT_NEAR(response.slope(weight), difference, 0.05F) << weight;
      EXPECT_EQ(response.slope(-weight), response.slope(weight));
    }
  }
}

TEST(Response, RejectsDecreasingKnots) {
  const std::vector<float> shares = {0.1F, 0.2F, 0.3F, 0.4F};
  EXPECT_THROW(Response(weights, std::vector<float>{0.1F}), Error);
  EXPECT_THROW(Response(std::vector<float>{0.1F, 0.1F, 0.5F, 0.75F}, shares), Error);
  EXPECT_THROW(Response(std::vector<float>{0.1F, 0.2F, 0.5F, 1.0F}, shares), Error);
  EXPECT_THROW(Response(weights, std::vector<float>{0.1F, 0.05F, 0.3F, 0.4F}), Error);
  EXPECT_THROW(Response(weights, std::vector<float>{0.1F, 0.2F, 0.3F, 1.1F}), Error);
  EXPECT_THROW(Response(weights, std::vector<float>{0.1F, 0.2F, 0.3F, std::nanf("")}), Error);
}

TEST(Member, TurnsEyesByTheWeightAndAllElseByItsShare) {
  Member member;
  member.entries = {{0, 2.0F}};
  member.turns = {{1, 0.4F}};
  member.response = Response(std::vector<float>{0.5F}, std::vector<float>{0.25F});
  std::vector<float> channels = {1.0F, 0.0F};
  member.add(0.5F, channels);
  EXPECT_FLOAT_EQ(channels[0], 1.5F);
  EXPECT_FLOAT_EQ(channels[1], 0.2F);
  const std::vector<float> by_channel = {3.0F, 5.0F};
  EXPECT_NEAR(member.slope(0.5F, by_channel), 6.0F * member.response.slope(0.5F) + 2.0F, 1e-5F);
}

}  // namespace
}  // namespace fascia::runtime
