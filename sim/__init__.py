"""The world and the sensor. Importing it registers `datmo/Lidar-v0` with Gymnasium."""

from gymnasium.envs.registration import register, registry

if "datmo/Lidar-v0" not in registry:
    register(id="datmo/Lidar-v0", entry_point="sim.env:LidarEnv")
