"""The judge: where the simulator meets perception. Importing it registers `datmo/Testbed-v0`."""

from gymnasium.envs.registration import register, registry

if "datmo/Testbed-v0" not in registry:
    register(id="datmo/Testbed-v0", entry_point="eval.testbed:make_testbed")
