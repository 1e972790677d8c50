"""The world and the sensor."""
